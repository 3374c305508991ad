"""The experiment of the paper that this project implements, sailed again; docs/paper.md tells the rest."""
