"""The camera: from views of a flat target to intrinsics, distortion and their covariance."""
