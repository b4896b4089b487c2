(define (domain crates)
  (:requirements :strips :typing)
  (:types robot room crate)
  (:predicates
    (at ?x - robot ?r - room) (way ?a ?b - room) (in ?c - crate ?r - room) (carried ?c - crate) (empty)
    (unseen ?r - room) (seen ?r - room))
  (:action go
    :parameters (?x - robot ?a ?b - room)
    :precondition (and (empty) (at ?x ?a) (way ?a ?b))
    :effect (and (at ?x ?b) (not (at ?x ?a))))
  (:action inspect
    :parameters (?x - robot ?r - room)
    :precondition (and (empty) (at ?x ?r) (unseen ?r))
    :effect (and (seen ?r) (not (unseen ?r))))
  (:action lift
    :parameters (?r - room ?c - crate)
    :precondition (and (empty) (at anna ?r) (at otto ?r) (in ?c ?r))
    :effect (and (carried ?c) (not (empty)) (not (in ?c ?r))))
  (:action carry
    :parameters (?a ?b - room ?c - crate)
    :precondition (and (carried ?c) (at anna ?a) (at otto ?a) (way ?a ?b))
    :effect (and (at anna ?b) (at otto ?b) (not (at anna ?a)) (not (at otto ?a))))
  (:action drop
    :parameters (?r - room ?c - crate)
    :precondition (and (carried ?c) (at anna ?r) (at otto ?r))
    :effect (and (in ?c ?r) (empty) (not (carried ?c)))))
