"""What is built, when each brick comes, and what must happen by theory."""
