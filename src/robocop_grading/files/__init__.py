"""What was handed in, packed for the sandbox and unpacked in it; what the platforms of courses export."""
