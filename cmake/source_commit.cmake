# Makes OUTPUT of TEMPLATE with @COMMIT@ the commit that is checked out in SOURCE, "+" behind it where
# files differ; empty outside a checkout. Left alone when nothing has changed, so that nothing is
# built anew.
set(COMMIT "")
execute_process(COMMAND git -C "${SOURCE}" describe --always --dirty=+ --exclude=*
                OUTPUT_VARIABLE COMMIT OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
configure_file("${TEMPLATE}" "${OUTPUT}" @ONLY)
