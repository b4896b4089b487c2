"""Playing scenarios with real goals."""
