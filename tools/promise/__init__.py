"""False fixes of simulated epochs beside the rate that was promised."""
