"""What helps where Newton's method fails on contact: easier forms that end at the form as given."""
