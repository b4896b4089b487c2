"""What all layers share: labels, parameters, the worker thread, names that load late."""
