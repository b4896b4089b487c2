(define (domain deliveries)
  (:requirements :strips :typing)
  (:types office package level)
  (:predicates
    (at ?o - office) (corridor ?a ?b - office) (start ?p - package ?o - office) (end ?p - package ?o - office)
    (carried ?p - package) (delivered ?p - package) (load ?l - level) (less ?l ?m - level))
  (:action move_base
    :parameters (?a ?b - office)
    :precondition (and (at ?a) (corridor ?a ?b))
    :effect (and (at ?b) (not (at ?a))))
  (:action pickup
    :parameters (?o - office ?l ?m - level ?p - package)
    :precondition (and (at ?o) (start ?p ?o) (load ?l) (less ?l ?m))
    :effect (and (carried ?p) (load ?m) (not (start ?p ?o)) (not (load ?l))))
  (:action deliver
    :parameters (?o - office ?l ?m - level ?p - package)
    :precondition (and (at ?o) (end ?p ?o) (carried ?p) (load ?m) (less ?l ?m))
    :effect (and (delivered ?p) (load ?l) (not (carried ?p)) (not (load ?m)))))
