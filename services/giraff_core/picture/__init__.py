"""Pictures of a camera: who asks for them, and what their headers say."""
