"""The interface layer: nodes that turn actions of a plan into actionlib goals and results into facts."""
