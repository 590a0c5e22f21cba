"""What helps where Newton's method fails on contact: families of easier forms that end at the form as given."""
