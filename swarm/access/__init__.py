"""Who may do what in a laboratory: identities, rights out of the key table, certificates, Zenoh's rules."""
