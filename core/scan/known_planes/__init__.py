"""Known planes: planes in the scene whose place the camera sees, such as a board's; sweeps are tied to them."""
