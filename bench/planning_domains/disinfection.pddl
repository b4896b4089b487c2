(define (domain disinfection)
  (:requirements :strips :typing)
  (:types room door level count)
  (:predicates
    (at ?r - room) (way ?a ?b - room) (door ?a ?b - room ?d - door) (adjacent ?d - door ?r - room)
    (shut ?d - door) (open ?d - door) (charge-at ?r - room)
    (battery ?l - level) (less ?l ?m - level) (full ?l - level)
    (urgent ?r - room) (normal ?r - room) (clean ?r - room)
    (left ?c - count) (fewer ?c ?d - count) (none ?c - count))
  (:action move_base
    :parameters (?a ?b - room ?l ?m - level)
    :precondition (and (at ?a) (way ?a ?b) (battery ?l) (less ?m ?l))
    :effect (and (at ?b) (battery ?m) (not (at ?a)) (not (battery ?l))))
  (:action move_base-through
    :parameters (?a ?b - room ?d - door ?l ?m - level)
    :precondition (and (at ?a) (door ?a ?b ?d) (open ?d) (battery ?l) (less ?m ?l))
    :effect (and (at ?b) (battery ?m) (not (at ?a)) (not (battery ?l))))
  (:action open
    :parameters (?r - room ?d - door)
    :precondition (and (at ?r) (adjacent ?d ?r) (shut ?d))
    :effect (and (open ?d) (not (shut ?d))))
  (:action shut
    :parameters (?r - room ?d - door)
    :precondition (and (at ?r) (adjacent ?d ?r) (open ?d))
    :effect (and (shut ?d) (not (open ?d))))
  (:action disinfect-urgent
    :parameters (?r - room ?l ?m - level ?c ?d - count)
    :precondition (and (at ?r) (urgent ?r) (battery ?l) (less ?m ?l) (left ?c) (fewer ?d ?c))
    :effect (and (clean ?r) (battery ?m) (left ?d) (not (urgent ?r)) (not (battery ?l)) (not (left ?c))))
  (:action disinfect
    :parameters (?r - room ?l ?m - level ?c - count)
    :precondition (and (at ?r) (normal ?r) (battery ?l) (less ?m ?l) (left ?c) (none ?c))
    :effect (and (clean ?r) (battery ?m) (not (normal ?r)) (not (battery ?l))))
  (:action charge
    :parameters (?r - room ?l ?m - level)
    :precondition (and (at ?r) (charge-at ?r) (battery ?l) (full ?m))
    :effect (and (battery ?m) (not (battery ?l)))))
