"""Who decides: genetic algorithms, islands, the archipelago and the command line."""
