# Builds Rimlight and bakes nothing: mount or copy bakes to /var/lib/rimlight.
#   docker build -t rimlight .
#   docker run --network host -v "$PWD/bakes:/var/lib/rimlight:ro" rimlight
FROM debian:bookworm-slim AS build
WORKDIR /src
COPY . .
RUN script/bootstrap && script/build release rimlight && script/install /opt/rimlight

FROM debian:bookworm-slim
COPY script/bootstrap /opt/rimlight/script/bootstrap
RUN /opt/rimlight/script/bootstrap --runtime && useradd --system --no-create-home rimlight
COPY --from=build /opt/rimlight /opt/rimlight
COPY script/health /opt/rimlight/script/health
USER rimlight
WORKDIR /var/lib/rimlight
HEALTHCHECK --interval=10s --timeout=3s CMD ["/opt/rimlight/script/health"]
ENTRYPOINT ["/opt/rimlight/bin/rimlight"]
CMD ["serve", "terrace.bake"]
