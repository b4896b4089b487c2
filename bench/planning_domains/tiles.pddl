(define (domain tiles)
  (:requirements :strips :typing)
  (:types tile cell)
  (:predicates (near ?c ?d - cell) (at ?t - tile ?c - cell) (free ?c - cell))
  (:action slide
    :parameters (?c ?d - cell ?t - tile)
    :precondition (and (near ?c ?d) (at ?t ?c) (free ?d))
    :effect (and (at ?t ?d) (free ?c) (not (at ?t ?c)) (not (free ?d)))))
