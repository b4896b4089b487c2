"""Search strategies: generators that yield questions to a grounding and receive the replies."""
