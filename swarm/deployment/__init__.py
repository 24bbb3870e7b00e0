"""From a laboratory file to machines that run what it says: wheels, releases, services, over SSH."""
