"""make campaign: scenarios over seeds against the published figures."""
