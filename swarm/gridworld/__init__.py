"""The grid worlds of section 2 and the compiled engine that runs its hundred-run studies."""
