//! The Python face of jostle.
