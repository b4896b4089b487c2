(define (domain blocks)
  (:requirements :strips :typing)
  (:types block)
  (:predicates (on ?b ?x - block) (on-table ?b - block) (clear ?b - block) (held ?b - block) (free))
  (:action pick
    :parameters (?b ?x - block)
    :precondition (and (free) (clear ?b) (on ?b ?x))
    :effect (and (held ?b) (clear ?x) (not (free)) (not (clear ?b)) (not (on ?b ?x))))
  (:action pick-from-table
    :parameters (?b - block)
    :precondition (and (free) (clear ?b) (on-table ?b))
    :effect (and (held ?b) (not (free)) (not (clear ?b)) (not (on-table ?b))))
  (:action put
    :parameters (?b ?x - block)
    :precondition (and (held ?b) (clear ?x))
    :effect (and (on ?b ?x) (clear ?b) (free) (not (held ?b)) (not (clear ?x))))
  (:action put-on-table
    :parameters (?b - block)
    :precondition (held ?b)
    :effect (and (on-table ?b) (clear ?b) (free) (not (held ?b)))))
