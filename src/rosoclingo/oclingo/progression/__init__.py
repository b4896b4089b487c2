"""Stream updates as data, their parser, ground terms and tokens."""
