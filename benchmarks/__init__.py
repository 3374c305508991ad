"""Side by side with peers, never timed tests: one file a question, `make bench` answers all."""
