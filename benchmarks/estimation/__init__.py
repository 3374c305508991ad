"""Estimators on recorded sensors: errors, noticing times, consistency."""
