"""Forms: internal force, tangent and state of bodies and links."""
