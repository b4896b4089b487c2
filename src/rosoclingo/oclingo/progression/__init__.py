"""What comes in: stream updates as data, their parser, ground terms and tokens."""
