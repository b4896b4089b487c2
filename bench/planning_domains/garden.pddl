(define (domain garden)
  (:requirements :strips :typing)
  (:types place level)
  (:predicates
    (at ?p - place) (tap ?p - place) (thirsty ?p - place) (watered ?p - place)
    (can ?l - level) (less ?l ?m - level) (full ?l - level))
  (:action move_base
    :parameters (?from ?to - place)
    :precondition (at ?from)
    :effect (and (at ?to) (not (at ?from))))
  (:action fill
    :parameters (?p - place ?l ?m - level)
    :precondition (and (at ?p) (tap ?p) (can ?l) (full ?m))
    :effect (and (can ?m) (not (can ?l))))
  (:action water
    :parameters (?p - place ?l ?m - level)
    :precondition (and (at ?p) (thirsty ?p) (can ?l) (less ?m ?l))
    :effect (and (watered ?p) (can ?m) (not (thirsty ?p)) (not (can ?l)))))
