"""What a job is and how it is split: pure values and functions, no input or output."""
