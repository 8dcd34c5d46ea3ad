"""What is made from run folders: pictures, curves, comparisons. Reads files only."""
