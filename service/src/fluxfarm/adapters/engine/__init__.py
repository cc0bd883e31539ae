"""Local engine processes and what is said to them."""
