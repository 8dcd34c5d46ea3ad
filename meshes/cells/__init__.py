"""Cells of high order: their nodes, their curved sides, their quality."""
