"""Picture to features: stripe centrelines, crossings, target corners."""
