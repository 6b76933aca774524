"""The fan: from poses of the plane target and the stripes on them to light planes and their covariance."""
