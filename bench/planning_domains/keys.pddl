(define (domain keys)
  (:requirements :strips :typing)
  (:types room thing hand)
  (:predicates
    (at ?r - room) (way ?a ?b - room) (lock ?a ?b - room ?k - thing) (adjacent ?k - thing ?r - room)
    (closed ?k - thing) (unlocked ?k - thing) (in ?t - thing ?r - room) (held ?h - hand ?t - thing) (free ?h - hand))
  (:action go
    :parameters (?a ?b - room)
    :precondition (and (at ?a) (way ?a ?b))
    :effect (and (at ?b) (not (at ?a))))
  (:action go-through
    :parameters (?a ?b - room ?k - thing)
    :precondition (and (at ?a) (lock ?a ?b ?k) (unlocked ?k))
    :effect (and (at ?b) (not (at ?a))))
  (:action take
    :parameters (?t - thing ?r - room ?h - hand)
    :precondition (and (at ?r) (in ?t ?r) (free ?h))
    :effect (and (held ?h ?t) (not (in ?t ?r)) (not (free ?h))))
  (:action put
    :parameters (?t - thing ?r - room ?h - hand)
    :precondition (and (at ?r) (held ?h ?t))
    :effect (and (in ?t ?r) (free ?h) (not (held ?h ?t))))
  (:action unlock
    :parameters (?k - thing ?r - room ?h - hand)
    :precondition (and (at ?r) (held ?h ?k) (adjacent ?k ?r) (closed ?k))
    :effect (and (unlocked ?k) (not (closed ?k)))))
