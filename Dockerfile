# The lab in a container: simulator, go-to server, bridge, grader and web page. How it is used: docs/container.md.

# What is installed in addition to what `./robocop run` needs: names of lists in install/deb-packages/.
ARG PARTS="hosting grade web"

# The Debian packages. .devcontainer/ uses this stage, with a checkout of its own.
FROM debian:12-slim AS packages
ARG PARTS
ENV LANG=C.UTF-8
COPY install/deb-packages /tmp/deb-packages
# PyPI has no wheels of pybullet for Linux on ARM, so there it is built. tini passes signals on and reaps orphans, which
# the first process of a container has to do. Removed at the end, 0.3 GB: what other packages bring along and nobody here
# uses, that is static libraries, tests, and what fontTools, which matplotlib needs, has for rare functions.
RUN set -eu; \
    lists="run $PARTS"; \
    if [ "$(dpkg --print-architecture)" != amd64 ]; then lists="$lists pybullet"; fi; \
    (cd /tmp/deb-packages && for list in $lists; do sed 's/#.*//' "$list.txt" || exit; done) >/tmp/packages; \
    apt-get update; \
    DEBIAN_FRONTEND=noninteractive xargs -a /tmp/packages apt-get install -y --no-install-recommends tini; \
    find /usr/lib -type f \( -name 'libicu*.a' -o -name 'libopenblas*.a' -o -name 'libpython*.a' \
      -o -path '*/dist-packages/*/tests/*' \) -delete; \
    rm -rf /usr/share/unicode /usr/lib/python3/dist-packages/sympy; \
    rm -rf /var/lib/apt/lists/* /var/cache/apt/* /var/log/apt /var/log/dpkg.log /tmp/packages; \
    useradd --create-home --uid 1000 --shell /bin/bash robocop

FROM packages
ARG PARTS
RUN install -d -o robocop -g robocop /home/robocop/aro_robocop_goto_as; \
    ln -s /home/robocop/aro_robocop_goto_as/robocop /usr/local/bin/robocop
USER robocop
WORKDIR /home/robocop/aro_robocop_goto_as
COPY --chown=robocop:robocop . .
# What the first grading would build is built here, as each start would repeat it.
RUN set -eu; \
    ./robocop setup $PARTS; \
    rm -rf ~/.cache; \
    case " $PARTS " in *" grade "*) ./robocop shell .robocop/venv/bin/python -m robocop_grading.submission ;; esac
WORKDIR /home/robocop

# The page listens on all of the container's addresses, because its loopback can't be published. Who reaches it is decided
# by the host: -p 127.0.0.1:8080:8080 for this machine only.
ENV ROBOCOP_WEB_HOST=0.0.0.0
# How messages tell the user to call ./robocop in a second terminal.
ENV ROBOCOP_COMMAND="docker exec -it robocop robocop"
EXPOSE 8080
ENTRYPOINT ["tini", "--", "robocop"]
CMD ["run", "rviz:=false", "web:=true"]
