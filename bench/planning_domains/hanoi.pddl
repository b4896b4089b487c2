(define (domain hanoi)
  (:requirements :strips)
  (:predicates (on ?d ?x) (clear ?x) (smaller ?d ?x))
  (:action move
    :parameters (?d ?from ?to)
    :precondition (and (smaller ?d ?to) (on ?d ?from) (clear ?d) (clear ?to))
    :effect (and (on ?d ?to) (clear ?from) (not (on ?d ?from)) (not (clear ?to)))))
