// The access token: it comes in the link's fragment, which no server ever sees, and leaves the
// address bar at once. This tab keeps it, so that the page can be loaded again.

const KEY = 'rimlight-token';

/** The token of `#token=…`, or the one that this tab has had; '' without one. */
export function takeToken({ location, history, sessionStorage }) {
  const token = new URLSearchParams(location.hash.slice(1)).get('token');
  if (token === null) return sessionStorage.getItem(KEY) ?? '';
  history.replaceState(history.state, '', location.pathname + location.search);
  sessionStorage.setItem(KEY, token);
  return token;
}

/** Headers of a request to the API. */
export function authorization(token) {
  return token ? { Authorization: `Bearer ${token}` } : {};
}
