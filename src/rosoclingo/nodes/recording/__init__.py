"""Recording of runs in bags: the recorder, the bag reader, replay."""
