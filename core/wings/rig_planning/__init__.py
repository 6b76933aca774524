"""What a rig will measure, foretold before it is built."""
