"""What a folder of displacement files holds, for whom knows little else of the test."""
