"""Virtual tests: geometry, true material, forward problem, camera."""
