"""What tracking systems send, byte by byte: no sockets, no arena."""
