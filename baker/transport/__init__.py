"""How the mass of one segment flows into another, and which points move where (section 3.4)."""
