"""What is to be inspected: features, part coordinates, conditions."""
