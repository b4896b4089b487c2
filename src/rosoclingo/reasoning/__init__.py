"""The core: goals, input feeder, action extractor, and the cycle that connects them."""
