"""Ways to search: generators that yield questions to a grounding and are sent the replies."""
