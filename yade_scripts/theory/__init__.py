"""Exact answers with which scenes and studies are compared."""
