"""The boat's own computer, where this program runs on it: configuration, Wi-Fi, update."""
