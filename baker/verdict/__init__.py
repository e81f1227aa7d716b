"""The verdict on a clip: which intervals look right, judged without knowing the true growth."""
