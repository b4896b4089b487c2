(define (domain elevator)
  (:requirements :strips :typing)
  (:types floor person room)
  (:predicates
    (at ?f - floor) (next ?f ?g - floor) (open) (closed) (free ?r - room)
    (waits ?p - person ?f - floor) (rides ?p - person ?r - room) (wants ?p - person ?f - floor) (arrived ?p - person))
  (:action lift
    :parameters (?f ?g - floor)
    :precondition (and (at ?f) (next ?f ?g) (closed))
    :effect (and (at ?g) (not (at ?f))))
  (:action doors-open
    :parameters ()
    :precondition (closed)
    :effect (and (open) (not (closed))))
  (:action doors-shut
    :parameters ()
    :precondition (open)
    :effect (and (closed) (not (open))))
  (:action board
    :parameters (?p - person ?f - floor ?r - room)
    :precondition (and (at ?f) (open) (waits ?p ?f) (free ?r))
    :effect (and (rides ?p ?r) (not (waits ?p ?f)) (not (free ?r))))
  (:action leave
    :parameters (?p - person ?f - floor ?r - room)
    :precondition (and (at ?f) (open) (rides ?p ?r) (wants ?p ?f))
    :effect (and (arrived ?p) (free ?r) (not (rides ?p ?r)))))
