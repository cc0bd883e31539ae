# The service with its engine, built by the same steps as `make build` on a machine.
FROM debian:bookworm-slim
WORKDIR /opt/fluxfarm
COPY . .
RUN apt-get update -q && apt-get install -y -q --no-install-recommends make git ca-certificates \
    && tools/setup-apt build && make build && rm -rf /var/lib/apt/lists/*
RUN useradd --system --create-home --home-dir /var/lib/fluxfarm fluxfarm && install -d -o fluxfarm /certificates
USER fluxfarm
ENV FLUXFARM_DATA=/var/lib/fluxfarm/data
VOLUME /var/lib/fluxfarm
EXPOSE 8460
CMD [".venv/bin/fluxfarm", "serve", "--host", "0.0.0.0", "--port", "8460"]
