(define (domain hanoi)
  (:requirements :strips)
  (:predicates (on ?d ?x) (clear ?x) (smaller ?d ?x) (peg ?p) (in ?x ?p))
  (:action move
    :parameters (?d ?from ?to ?p ?q)
    :precondition (and (smaller ?d ?to) (peg ?p) (peg ?q) (on ?d ?from) (in ?d ?p) (in ?to ?q) (clear ?d) (clear ?to))
    :effect (and (on ?d ?to) (in ?d ?q) (clear ?from) (not (on ?d ?from)) (not (in ?d ?p)) (not (clear ?to)))))
