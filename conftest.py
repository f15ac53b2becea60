"""Settings of every test run: the validation report and the long hypothesis profile."""

from hypothesis import HealthCheck, settings

pytest_plugins = ["validation_plugin"]

settings.register_profile("fuzz", max_examples=20_000, deadline=None, suppress_health_check=list(HealthCheck))
