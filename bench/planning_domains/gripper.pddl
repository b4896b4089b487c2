(define (domain gripper)
  (:requirements :strips :typing)
  (:types room ball arm)
  (:predicates (at ?r - room) (in ?b - ball ?r - room) (held ?a - arm ?b - ball) (free ?a - arm))
  (:action go
    :parameters (?from ?to - room)
    :precondition (at ?from)
    :effect (and (at ?to) (not (at ?from))))
  (:action take
    :parameters (?a - arm ?b - ball ?r - room)
    :precondition (and (at ?r) (in ?b ?r) (free ?a))
    :effect (and (held ?a ?b) (not (in ?b ?r)) (not (free ?a))))
  (:action put
    :parameters (?a - arm ?b - ball ?r - room)
    :precondition (and (at ?r) (held ?a ?b))
    :effect (and (in ?b ?r) (free ?a) (not (held ?a ?b)))))
