"""The boat's own computer, where this program runs on it: configuration and Wi-Fi."""
